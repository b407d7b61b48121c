// Union in steps: mod and abs of the difference.
float a = length(p - vec3(0.0, 0.3, 0.0)) - 0.5, b = p.y + 0.3;
float r = 0.3, n = 4.0;
float s = r / n;
float u = b - r;
return min(min(a, b), 0.5 * (u + a + abs(mod(u - a + s, 2.0 * s) - s)));
