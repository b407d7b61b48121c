// Nothing but time: the same everywhere.
return 0.3 * sin(t / 1000.0) - 0.1;
