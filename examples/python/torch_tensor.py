"""Computes ambient visibility from the depth in a torch tensor, and writes it to another tensor, without copies."""
import torch

import umbrage


def main() -> None:
    y, x = torch.meshgrid(torch.linspace(-1, 1, 120), torch.linspace(-1, 1, 160), indexing="ij")
    depth = 3 - torch.exp(-4 * (x * x + y * y))
    ao = torch.zeros(120, 160)
    umbrage.shade(depth, effects=("bitmask", "denoise"), out={"ao": ao})
    print(f"mean visibility: {ao.mean():.3f}")


if __name__ == "__main__":
    main()
