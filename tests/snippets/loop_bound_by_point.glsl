// The number of rounds depends on the point.
int n = 2 + int(floor((p.x + 1.0) * 3.0));
float d = 1.0;
for (int i = 0; i < n; ++i) d = min(d, abs(p.y - 0.25 * float(i) + 0.6) + 0.1 * length(p.xz));
return d - 0.12;
