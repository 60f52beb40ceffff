"""A torch tensor becomes shaded, and the occlusion is a tensor again, without a copy of either."""
import torch

import umbrage


def main() -> None:
    y, x = torch.meshgrid(torch.linspace(-1, 1, 120), torch.linspace(-1, 1, 160), indexing="ij")
    depth = 3 - torch.exp(-4 * (x * x + y * y))
    ao = torch.zeros(120, 160)
    umbrage.shade(depth, effects=("bitmask", "denoise"), out={"ao": ao})
    print(f"{ao.mean():.3f} of the light arrives")


if __name__ == "__main__":
    main()
