// Rings around y, warped by sines of the angle.
float r = length(p.xz) + 0.02 * sin(5.0 * atan(p.x, p.z) + 3.0 * p.y);
return 0.4 * (abs(fract(r * 4.0) - 0.5) - 0.25);
