// The sum of up to 1023 samples of 24 bits, and their number, in two words: the first has the sum of the samples' upper
// 12 bits (22 bits) below the number (10 bits), the second the sum of their lower 12 bits.
const int kSplit = 12, kNumberShift = 22;
const uint kSplitMask = 4095u, kHighMask = (1u << kNumberShift) - 1u;

// Returns the words of one sample.
uvec2 words_of(uint steps) { return uvec2((1u << kNumberShift) + (steps >> kSplit), steps & kSplitMask); }
