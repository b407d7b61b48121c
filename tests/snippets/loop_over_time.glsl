// Time inside a loop: the phases differ from round to round.
float d = 1.0;
for (int i = 0; i < 6; ++i) {
  float a = float(i) * 1.0471976 + t * 0.001;
  d = min(d, length(p.xy - 0.5 * vec2(cos(a), sin(a))) - 0.15);
}
return max(d, abs(p.z) - 0.3);
