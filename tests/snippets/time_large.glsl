// A fast phase, huge after an hour, in the argument of a sine together with space.
return 0.5 * (length(p) - 0.5) - 0.05 * sin(8.0 * p.x + 0.25 * t) + 0.03 * cos(0.1 * t - 5.0 * p.y);
