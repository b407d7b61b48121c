// Menger sponge, three levels (Quilez, "Menger fractal").
vec3 a = abs(p) - 0.8;
float d = length(max(a, 0.0)) + min(max(a.x, max(a.y, a.z)), 0.0);
float s = 1.25;
for (int m = 0; m < 3; m++) {
  vec3 q = mod(p * s, 2.0) - 1.0;
  s *= 3.0;
  vec3 r = abs(1.0 - 3.0 * abs(q));
  float c = (min(max(r.x, r.y), min(max(r.y, r.z), max(r.z, r.x))) - 1.0) / s;
  d = max(d, c);
}
return d;
