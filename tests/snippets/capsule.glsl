// Points within a radius of a segment.
vec3 a = vec3(-0.4, -0.5, 0.1), b = vec3(0.5, 0.4, -0.2);
vec3 pa = p - a, ba = b - a;
float h = clamp(dot(pa, ba) / dot(ba, ba), 0.0, 1.0);
return length(pa - ba * h) - 0.2;
