"""Shades a torch tensor and writes ambient visibility to another tensor, without copies."""
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
