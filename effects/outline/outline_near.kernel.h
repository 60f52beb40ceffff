// How far outline_strays_row and outline_strays_near look: as lanes look around at once.

CONST int kStraysNear = 16;  // pixels
