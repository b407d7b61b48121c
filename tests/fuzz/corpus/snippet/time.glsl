#define K(x) (x * t)
float g(float a) { return a; }
// ---- body
float d[3]; for (int i = 0; i < 3; ++i) { d[i] = g(float(i)) - K(p.x); if (d[i] > 1.0) break; }
return mix(d[int(p.y) & 1], 1.0 / t, fract(p.z));
