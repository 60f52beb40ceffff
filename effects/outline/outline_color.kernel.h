// Writes the colour of the lines to every pixel; `output` draws the lines.
OUT_COLOR(line)

FN void outline_color_pixel(Int px, Int py) { store_line(Vec3(Real(C.r), Real(C.g), Real(C.b))); }
