// fma, modf, ldexp and isnan.
float whole;
float part = modf(p.x * 3.0, whole);
float d = fma(p.y, 0.5, part * 0.1) + ldexp(p.z, -2) + 0.02 * whole;
return isnan(d) ? 0.0 : d;
