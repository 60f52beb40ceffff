// Packs the sum and the number of up to 1023 samples of 24 bits into two words. The first contains the number of samples
// (upper 10 bits) and the sum of their upper 12 bits (lower 22 bits); the second contains the sum of their lower 12 bits.
const int kSplit = 12, kNumberShift = 22;
const uint kSplitMask = 4095u, kHighMask = (1u << kNumberShift) - 1u;

// Returns the words of one sample.
uvec2 words_of(uint steps) { return uvec2((1u << kNumberShift) + (steps >> kSplit), steps & kSplitMask); }
