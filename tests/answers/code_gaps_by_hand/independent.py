"""The clauses, one line each, in centimetres."""

PROGRAM = "by hand"

root = (12**2 + 9**2) ** 0.5
total = 12 + 9
one, two = max(5, 12 + 0.003 * 2400), max(5, 9 + 0.003 * 1500)
gaps = {
    "srss": root,
    "share_of_sum": total,
    "asce_7": root,
    "canada": root,
    "eurocode_8": 0.7 * root,
    "ubc_97": root,
    "mexico_city": (one + two) / 2,
    "is_1893": total / 2,
    "taiwan": 0.6 * total,
    "peru_e030": max(0.006 * 1500, 3, total * 2 / 3),
}
ANSWERS = {"gap": [gap / 100 for gap in gaps.values()]}
NUMBERS = {"root": root, "total": total, "one": one, "two": two}
