// Ends the kernel dialect that kernel_begin.h starts.
#undef FN
#undef FN_RARE
#undef CONST
#undef IN_REAL
#undef IN_TRIPLE
#undef IN_VECTOR
#undef IN_COLOR
#undef OF_LAYERS
#undef IN_LAYERS_REAL
#undef IN_LAYERS_TRIPLE
#undef IN_LAYERS_VECTOR
#undef IN_LAYERS_COLOR
#undef OUT_REAL
#undef OUT_ALPHA
#undef OUT_TRIPLE
#undef OUT_VECTOR
#undef OUT_COLOR
