// A sphere that wobbles: its radius a harmonic of direction and time.
float r = length(p);
float angle = atan(p.z, p.x + 1e-6);
return 0.5 * (r - 0.6 - 0.08 * sin(4.0 * angle + 0.004 * t) * (1.0 - p.y * p.y));
