// asin, acos and atan away from their kinks.
float a = asin(clamp(p.x * 0.6, -0.9, 0.9)) - acos(clamp(p.y * 0.6, -0.9, 0.9)) + atan(p.z * 2.0);
return 0.2 * a + 0.1 * tan(p.x * 0.5);
