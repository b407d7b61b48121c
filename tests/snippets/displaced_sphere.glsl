// A sphere with a sine displacement, scaled to stay a bound.
float bump = sin(9.0 * p.x) * sin(9.0 * p.y) * sin(9.0 * p.z);
return (length(p) - 0.65 + 0.05 * bump) * 0.7;
