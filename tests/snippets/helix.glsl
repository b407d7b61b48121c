// A strand that winds around y: the nearest turn by rounding.
float angle = atan(p.z, p.x);
float pitch = 0.5;
float turn = p.y / pitch - angle / 6.2831853;
float off = (turn - round(turn)) * pitch;
return 0.7 * (length(vec2(length(p.xz) - 0.5, off)) - 0.1);
