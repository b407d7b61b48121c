// Union with a 45 degree chamfer.
float a = length(p.xz) - 0.3, b = abs(p.y) - 0.2;
return min(min(a, b), (a - 0.2 + b) * sqrt(0.5));
