// Distance to a parabola's sheet by Newton steps, the closest point found in a do-while.
float x = p.x, step_size;
int rounds = 0;
do {
  float g = 2.0 * (x - p.x) + 4.0 * x * (x * x - p.y);
  float h = 2.0 + 12.0 * x * x - 4.0 * p.y;
  step_size = g / max(h, 0.5);
  x -= 0.8 * step_size;
  rounds++;
} while (abs(step_size) > 1e-3 && rounds < 12);
return length(vec2(x - p.x, x * x - p.y)) - 0.2;
