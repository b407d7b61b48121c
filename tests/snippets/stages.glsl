// An animation in stages: a switch over the second, chosen by time alone.
int stage = int(mod(floor(t / 1000.0), 3.0) + 0.5);
float d;
switch (stage) {
  case 0: d = length(p) - 0.5; break;
  case 1: d = max(abs(p.x), max(abs(p.y), abs(p.z))) - 0.45; break;
  default: d = length(vec2(length(p.xz) - 0.5, p.y)) - 0.15; break;
}
return d;
