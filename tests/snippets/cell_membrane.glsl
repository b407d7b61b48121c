// A two-layered membrane around a wobbling ball.
float wobble = 0.05 * sin(7.0 * p.x + t * 0.001) * sin(6.0 * p.y + t * 0.0013) * sin(8.0 * p.z);
float d = length(p) - 0.7 + wobble;
return 0.6 * (abs(abs(d) - 0.06) - 0.02);
