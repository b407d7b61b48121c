// A logarithmic spiral that turns.
float r = length(p.xy) + 1e-4;
float a = atan(p.y, p.x) + 0.001 * t;
float d = sin(a * 2.0 + 4.0 * log(r)) * r * 0.15;
return max(d, abs(p.z) - 0.2);
