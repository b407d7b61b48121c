// Torus around y. Exact.
vec2 q = vec2(length(p.xz) - 0.6, p.y);
return length(q) - 0.2;
