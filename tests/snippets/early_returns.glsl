// Many ways out, one of them in a loop.
if (p.x > 0.8) return p.x - 0.9;
float r = 0.7;
for (int i = 0; i < 5; ++i) {
  float d = length(p - vec3(0.0, 0.0, 0.2 * float(i) - 0.4)) - r * 0.4;
  if (d < 0.0) return 0.5 * d;
  if (p.y > 0.5 && i == 2) continue;
  r -= 0.05;
}
return length(p.xy) - 0.2;
