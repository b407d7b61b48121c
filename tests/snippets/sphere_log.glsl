// Distance through exp and log: log-sum-exp of two spheres, a smooth union (exponential form).
float k = 12.0;
float a = length(p - vec3(0.3, 0.0, 0.0)) - 0.4;
float b = length(p + vec3(0.3, 0.1, 0.0)) - 0.35;
return -log(exp(-k * a) + exp(-k * b)) / k;
