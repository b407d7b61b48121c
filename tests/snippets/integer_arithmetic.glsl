// Division, remainder and conversion of integers, signed and unsigned.
int a = int(p.x * 20.0) + 30, b = int(p.y * 10.0) + 12;
uint c = uint(a) / 7u + uint(b) % 5u;
int d = a / b - a % b + min(a, b) - max(a, 3 * b) + abs(b - a) + sign(a - b);
return 0.01 * float(d) + 0.02 * float(c) + 0.5 * p.z;
