// A catenoid: cosh and its relatives.
float neck = 0.3 * cosh(p.y / 0.45);
float d = length(p.xz) - neck;
return 0.4 * d + 0.05 * tanh(3.0 * p.y) * sinh(p.x * 0.3);
