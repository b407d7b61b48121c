// exp2, log2, sqrt, inversesqrt of positive numbers.
float r2 = dot(p, p) + 0.1;
return 0.3 * (log2(r2 + 1.0) - 0.7) + 0.1 * (exp2(-r2) - inversesqrt(r2 + 1.0)) + 0.05 * sqrt(r2);
