// Hexagonal cells in the xz plane: the nearer of two rectangular lattices.
const vec2 s = vec2(1.0, 1.7320508);
vec2 x = p.xz * 3.0;
vec2 a = mod(x, s) - 0.5 * s, b = mod(x + 0.5 * s, s) - 0.5 * s;
vec2 g = dot(a, a) < dot(b, b) ? a : b;
g = abs(g);
float edge = max(dot(g, s * 0.5), g.x);
return (edge - 0.42) / 3.0;
