// User parameters of `gooch` and the constants of its kernel. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_GOOCH_H
#define UMBRAGE_EFFECTS_GOOCH_H

// Values of GoochParams::tones and values.
const int kGoochOwn = 0, kGoochPaper = 1;
const int kGoochLight = 0, kGoochDisplay = 1;

// One row of the table in gooch.cpp per field.
struct GoochParams {
  int tones;                // kGoochOwn: the four fields below; kGoochPaper: those of the paper's figures
  float blue, yellow;       // b and y: the cool and the warm tone of a black surface, display values
  float alpha, beta;        // how much of the surface's colour is added to the cool and to the warm tone
  float hue;                // how much saturated colours keep their hue: 0, the sum of the paper; 1, within 12 degrees
  float highlight;          // strength of the highlight, 0 to 1
  float shininess;          // exponent of the highlight
  float light_azimuth_deg;  // direction to the light, from that to the camera: to the right,
  float light_elevation_deg;  // and upwards
  float occlusion;            // factor for 1 - ao
  int values;                 // kGoochLight: `lit` is linear light; kGoochDisplay: display values
};

struct GoochConstants {
  float blue, yellow, alpha, beta, hue;
  float highlight, shininess, occlusion;
  int values;
  float light_x, light_y, light_z;  // unit direction to the light, view space
};

#endif
