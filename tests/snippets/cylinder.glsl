// Capped cylinder along y. Exact.
vec2 d = abs(vec2(length(p.xz), p.y)) - vec2(0.4, 0.7);
return min(max(d.x, d.y), 0.0) + length(max(d, 0.0));
