// Barr's supertoroid with exponents 3 and 1.5.
float ring = pow(pow(abs(p.x), 3.0) + pow(abs(p.z), 3.0), 1.0 / 3.0) - 0.55;
return pow(pow(abs(ring), 1.5) + pow(abs(p.y), 1.5), 1.0 / 1.5) - 0.2;
