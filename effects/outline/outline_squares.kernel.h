// How far outline_strays_row and outline_strays_near look.

CONST int kStraysNear = 10;  // pixels
