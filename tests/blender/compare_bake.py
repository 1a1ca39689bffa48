# SPDX-License-Identifier: GPL-3.0-or-later
"""Compare the irradiance pages of an Ajar bake with a reference written by cycles_bake.py.

    python3 tests/blender/compare_bake.py --package DIR/package --reference REF.npz [--out DIR]
            [--tolerance 0.05] [--sigma 1] [--max-back 0.25] [--worst 20]
            [--require-mean 0.01] [--require-share 0.95]

A texel agrees if its luminance differs by at most tolerance * reference + sigma * the combined
standard error of both bakes. Compared are texels that Ajar calls valid, that Cycles baked and that
lie in exactly one triangle. Left out, unless --max-back 1, are texels that look into solids (more than
a quarter of their rays meet back faces) or that coincide with an opposite face: there the two differ
by intent. With --require-* the exit code tells whether the bakes agree.
"""
import argparse
import json
import os
import sys

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from support import exr, png  # noqa: E402

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


class Page:
    """One page of both bakes; all arrays (h, w[, 3]), bottom row first."""

    def __init__(self, package, entry, reference, index, max_back=0.25):
        self.index = index
        self.ajar = exr.read_rgb(os.path.join(package, entry['irradiance'])).astype(np.float64)
        quality = exr.read_exr(os.path.join(package, entry['quality']))
        self.ajar_error = quality['stderr'].astype(np.float64)
        self.validity = quality['validity']
        read = lambda name: reference[f'{index}_{name}']  # noqa: E731
        self.reference = read('mean').astype(np.float64)
        self.reference_error = read('stderr').astype(np.float64) @ LUMINANCE
        self.position, self.object, self.material = read('position'), read('object'), read('material')
        self.covered = read('valid')
        self.valid = (self.validity > 0.99) & self.covered & (read('overlap') <= 1)
        self.valid &= np.isfinite(self.ajar).all(-1) & np.isfinite(self.reference).all(-1)
        self.back = read('back')
        if max_back < 1:
            self.valid &= (self.back <= max_back) & ~read('coincident')
        self.border = self.covered & ~_all_neighbours(self.object >= 0, self.object)


def _all_neighbours(mask, label):
    """True where all eight neighbours are in the mask and carry the same label."""
    result = np.zeros_like(mask)
    inner = result[1:-1, 1:-1]
    inner[:] = True
    centre = label[1:-1, 1:-1]
    for dy in (0, 1, 2):
        for dx in (0, 1, 2):
            window = np.s_[dy : dy + mask.shape[0] - 2, dx : dx + mask.shape[1] - 2]
            inner &= mask[window] & (label[window] == centre)
    return result


class Texels:
    """The compared texels of all pages as flat arrays."""

    def __init__(self, pages):
        self.pages = pages
        pick = lambda name: np.concatenate([getattr(p, name)[p.valid] for p in pages])  # noqa: E731
        self.ajar, self.reference = pick('ajar'), pick('reference')
        self.a, self.r = self.ajar @ LUMINANCE, self.reference @ LUMINANCE
        self.ajar_error, self.reference_error = pick('ajar_error'), pick('reference_error')
        self.error = np.hypot(self.ajar_error, self.reference_error)
        self.position, self.object, self.material = pick('position'), pick('object'), pick('material')
        self.border, self.back = pick('border'), pick('back')
        self.xy = np.concatenate(
            [np.stack([np.full(p.valid.sum(), p.index), *np.nonzero(p.valid)[::-1]], -1) for p in pages]
        )

    def agree(self, tolerance, sigma):
        """Mask of texels that agree."""
        return np.abs(self.a - self.r) <= tolerance * np.abs(self.r) + sigma * self.error

    def relative(self):
        """Signed relative difference, softened where the reference is almost black."""
        return (self.a - self.r) / np.maximum(self.r, 1e-3 * self.r.mean() + 1e-30)


def summarize(texels, args):
    """Numbers of the whole comparison."""
    agree = texels.agree(args.tolerance, args.sigma)
    relative = texels.relative()
    mean = texels.reference.mean(0)
    inner = ~texels.border
    bounds = [f"{p:g}" for p in (1, 5, 25, 50, 75, 95, 99)]
    return {
        'texels': len(agree),
        'mean_ratio': float(texels.a.mean() / texels.r.mean()),
        'mean_ratio_rgb': (texels.ajar.mean(0) / np.where(mean > 0, mean, 1)).tolist(),
        'mean_ratio_interior': float(texels.a[inner].mean() / texels.r[inner].mean())
        if inner.any()
        else None,
        'share': float(agree.mean()),
        'share_interior': float(agree[inner].mean()) if inner.any() else None,
        'share_border': float(agree[~inner].mean()) if (~inner).any() else None,
        'border_texels': int((~inner).sum()),
        'by_back_share': back_rows(texels, agree),
        'share_without_noise_allowance': float(texels.agree(args.tolerance, 0).mean()),
        'relative_percentiles': dict(
            zip(bounds, np.percentile(relative, [float(b) for b in bounds]).tolist())
        ),
        'rms_relative': float(np.sqrt(np.mean(relative**2))),
        'ajar_median_relative_stderr': _median_ratio(texels.ajar_error, texels.a),
        'reference_median_relative_stderr': _median_ratio(texels.reference_error, texels.r),
        'z_rms': float(np.sqrt(np.mean(((texels.a - texels.r) / np.maximum(texels.error, 1e-12)) ** 2))),
    }


def back_rows(texels, agree):
    """{range of back-face share: [texels, mean ratio, share agreeing]}."""
    rows = {}
    for low, high in ((-1, 0), (0, 0.05), (0.05, 0.25), (0.25, 0.6), (0.6, 1)):
        mask = (texels.back > low) & (texels.back <= high)
        if mask.any():
            rows[f"<={high}"] = [
                int(mask.sum()),
                round(float(texels.a[mask].sum() / max(texels.r[mask].sum(), 1e-30)), 4),
                round(float(agree[mask].mean()), 4),
            ]
    return rows


def _median_ratio(error, value):
    lit = value > 0
    return float(np.median(error[lit] / value[lit])) if lit.any() else None


def by_group(texels, labels, names, agree):
    """Rows (name, texels, mean ratio, share agreeing), most disagreeing texels first."""
    rows = []
    for index in np.unique(labels[labels >= 0]):
        mask = labels == index
        rows.append(
            {
                'name': names[index],
                'texels': int(mask.sum()),
                'ratio': float(texels.a[mask].sum() / max(texels.r[mask].sum(), 1e-30)),
                'share': float(agree[mask].mean()),
                'bad': int((~agree[mask]).sum()),
            }
        )
    return sorted(rows, key=lambda row: -row['bad'])


def worst(texels, meta, count):
    """The texels with the largest absolute excess over tolerance and noise."""
    excess = np.abs(texels.a - texels.r) - 2 * texels.error
    rows = []
    for i in np.argsort(-excess)[:count]:
        rows.append(
            {
                'page_x_y': texels.xy[i].tolist(),
                'position': np.round(texels.position[i], 3).tolist(),
                'object': _name(meta['objects'], texels.object[i]),
                'material': _name(meta['materials'], texels.material[i]),
                'border': bool(texels.border[i]),
                'ajar': float(texels.a[i]),
                'reference': float(texels.r[i]),
                'sigmas': float((texels.a[i] - texels.r[i]) / max(texels.error[i], 1e-12)),
            }
        )
    return rows


def _name(names, index):
    return names[index] if index >= 0 else "(none)"


def write_maps(page, directory, exposure):
    """PNG of Ajar | reference | signed relative error (red: Ajar brighter, full at 20%)."""
    relative = ((page.ajar - page.reference) @ LUMINANCE) / np.maximum(
        page.reference @ LUMINANCE, 0.02 / exposure
    )
    scaled = np.clip(relative / 0.2, -1, 1)[..., None]
    color = np.where(scaled > 0, 1 - scaled * [0, 1, 1], 1 + scaled * [1, 1, 0])
    color[~page.valid] = 0.25
    pictures = [png.srgb(page.ajar * exposure), png.srgb(page.reference * exposure), color]
    png.write_png(os.path.join(directory, f"page_{page.index}_compare.png"), np.concatenate(pictures, axis=1))


def print_report(summary, materials, objects, texels):
    """Human-readable summary."""
    for name, value in summary.items():
        print(f"{name:34} {value if not isinstance(value, float) else format(value, '.5g')}")
    for title, rows in (("material", materials), ("object", objects)):
        print(f"most disagreeing by {title}: bad/texels, mean ratio")
        for row in rows[:8]:
            print(f"  {row['bad']:6}/{row['texels']:<6} {row['ratio']:.4f}  {row['name']}")
    print("worst texels")
    for row in texels:
        print("  " + json.dumps(row))


def parse():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument('--package', required=True)
    parser.add_argument('--reference', required=True)
    parser.add_argument('--out', help="folder for compare.json and error maps")
    parser.add_argument('--tolerance', type=float, default=0.05)
    parser.add_argument('--sigma', type=float, default=1.0)
    parser.add_argument('--max-back', type=float, default=0.25)
    parser.add_argument('--worst', type=int, default=20)
    parser.add_argument('--require-mean', type=float, help="largest |mean ratio - 1|")
    parser.add_argument('--require-share', type=float, help="smallest share of agreeing texels")
    return parser.parse_args()


def load(package, reference_path, max_back=0.25):
    """(pages, meta) of both bakes."""
    with open(os.path.join(package, 'manifest.json'), encoding='utf-8') as file:
        entries = json.load(file)['pages']
    reference = np.load(reference_path)
    pages = [Page(package, entry, reference, i, max_back) for i, entry in enumerate(entries)]
    return pages, json.loads(str(reference['meta']))


def failed(summary, args):
    """True if a required bound is missed."""
    return (args.require_mean is not None and not abs(summary['mean_ratio'] - 1) <= args.require_mean) or (
        args.require_share is not None and not summary['share'] >= args.require_share
    )


def main():
    args = parse()
    pages, meta = load(args.package, args.reference, args.max_back)
    texels = Texels(pages)
    if not len(texels.a):
        sys.exit("no texel to compare")
    summary = summarize(texels, args)
    agree = texels.agree(args.tolerance, args.sigma)
    materials = by_group(texels, texels.material, meta['materials'], agree)
    objects = by_group(texels, texels.object, meta['objects'], agree)
    rows = worst(texels, meta, args.worst)
    print_report(summary, materials, objects, rows)
    if args.out:
        os.makedirs(args.out, exist_ok=True)
        for page in pages:
            write_maps(page, args.out, 0.5 / max(np.percentile(texels.r, 75), 1e-12))
        with open(os.path.join(args.out, 'compare.json'), 'w', encoding='utf-8') as file:
            json.dump(
                {'summary': summary, 'materials': materials, 'objects': objects, 'worst': rows},
                file,
                indent=1,
            )
    return int(failed(summary, args))


if __name__ == "__main__":
    sys.exit(main())
