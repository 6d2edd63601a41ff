"""The clauses, one line each, in centimetres."""

PROGRAM = "by hand"

peaks, heights = (12, 9), (2400, 1500)
root = (peaks[0] ** 2 + peaks[1] ** 2) ** 0.5
total = sum(peaks)
with_heights = [max(5, peak + 0.003 * height) for peak, height in zip(peaks, heights, strict=True)]
by_height = [max(5, 0.009 * height) for height in heights]
gaps = {
    "srss": root,
    "share_of_sum": total,
    "asce_7": root,
    "canada": root,
    "eurocode_8": 0.7 * root,
    "ubc_97": root,
    "mexico_city": sum(with_heights) / 2,
    "is_1893": total / 2,
    "taiwan": 0.6 * total,
    "peru_e030": max(0.006 * min(heights), 3, total * 2 / 3),
    "asce_41": 0.04 * min(heights),
    "mexico_city_simplified": sum(by_height) / 2,
    "china_gb_50011": 10 + 2 * max(0, min(heights) - 1500) / 300,
}
ANSWERS = {"gap": [gap / 100 for gap in gaps.values()]}
NUMBERS = {
    **{"peaks": peaks, "heights": [height / 100 for height in heights], "root": root, "total": total},
    **{"with_heights": with_heights, "of_height": 0.006 * min(heights)},
    **{"by_height": by_height, "share_of_height": 0.04 * min(heights)},
}
