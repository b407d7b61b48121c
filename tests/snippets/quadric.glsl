// A quadric given by a symmetric 4x4 matrix: x^T Q x, over the length of its gradient.
mat4 q = mat4(1.0, 0.1, 0.0, 0.0, 0.1, 2.0, 0.2, 0.0, 0.0, 0.2, -0.5, 0.1, 0.0, 0.0, 0.1, -0.3);
vec4 x = vec4(p, 1.0);
vec4 g = q * x;
return dot(x, g) / (2.0 * length(g.xyz) + 0.2);
