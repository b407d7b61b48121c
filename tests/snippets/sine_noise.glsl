// The classical fract(sin) hash: discontinuous, and different on every device beyond the last bits.
vec2 cell = floor(p.xz * 2.0);
float h = fract(sin(dot(cell, vec2(12.9898, 78.233))) * 43.758);
return p.y - 0.3 * h;
