// Writes the colour of the lines, which `output` draws, to every pixel.
OUT_COLOR(line)

FN void outline_color_pixel(Int px, Int py) { store_line(Vec3(Real(C.r), Real(C.g), Real(C.b))); }
