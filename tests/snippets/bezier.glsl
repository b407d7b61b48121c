// Distance to a quadratic Bezier curve by samples and one refinement, in helpers.
vec3 curve(float s) {
  vec3 a = vec3(-0.7, -0.4, 0.0), b = vec3(0.0, 0.9, 0.3), c = vec3(0.7, -0.3, -0.2);
  return mix(mix(a, b, s), mix(b, c, s), s);
}
float distance_at(vec3 q, float s) { return distance(q, curve(s)); }
// ---- body
float best = 0.0, nearest = 10.0;
for (int i = 0; i <= 8; ++i) {
  float s = float(i) / 8.0, d = distance_at(p, s);
  if (d < nearest) {
    nearest = d;
    best = s;
  }
}
float h = 1.0 / 16.0;
for (int i = 0; i < 4; ++i, h *= 0.5) {
  float below = distance_at(p, best - h), above = distance_at(p, best + h);
  best += below < above ? -0.5 * h : 0.5 * h;
}
return min(nearest, distance_at(p, best)) - 0.08;
