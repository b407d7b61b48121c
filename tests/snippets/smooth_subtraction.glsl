// A sphere smoothly taken from another.
float k = 0.15;
float a = length(p - vec3(0.4, 0.2, 0.1)) - 0.4;
float b = length(p) - 0.7;
float h = max(k - abs(-a - b), 0.0) / k;
return max(-a, b) + h * h * k * 0.25;
