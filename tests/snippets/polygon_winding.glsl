// A 2D polygon, extruded: loop over an array with a wrapped index, the sign by crossings (Quilez, "Polygon").
const vec2 v[5] = vec2[5](vec2(0.6, 0.0), vec2(0.2, 0.6), vec2(-0.5, 0.4), vec2(-0.2, 0.0), vec2(-0.5, -0.5));
float d = dot(p.xy - v[0], p.xy - v[0]);
float s = 1.0;
for (int i = 0, j = 4; i < 5; j = i, i++) {
  vec2 e = v[j] - v[i], w = p.xy - v[i];
  vec2 b = w - e * clamp(dot(w, e) / dot(e, e), 0.0, 1.0);
  d = min(d, dot(b, b));
  bvec3 c = bvec3(p.y >= v[i].y, p.y < v[j].y, e.x * w.y > e.y * w.x);
  if (all(c) || all(not(c))) s = -s;
}
return max(s * sqrt(d), abs(p.z) - 0.4);
