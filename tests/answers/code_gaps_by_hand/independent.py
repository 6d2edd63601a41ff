"""The clauses, one line each, in centimetres.

Mexico City, NTC-Sismo 1.10: every building keeps the distance from its boundary, and two keep the sum;
half of it is allowed "si los dos cuerpos tienen la misma altura y estructuración y, además, las losas
coinciden a la misma altura, en todos los niveles". IBC 2009, as ASCE 7, 12.12.3: the root of squares for
"adjacent buildings on the same property"; from a property line the own displacement. Peru, E.030, 33.2:
2/3 of the sum, and s = 0.006 h, 0.03 m at least; 33.3: from a property line 2/3 of the own displacement,
and s/2. From memory, their texts not seen: Eurocode 8, 4.4.2.7: (2) b the root of squares within one
property, a the own displacement from its line, (3) 0.7 of it for floors at the same elevations; IS 1893
of 2016, 7.11.3: R1 d1 + R2 d2 for level floors.
"""

PROGRAM = "by hand"

peaks, heights, alike = (12, 9), (2400, 1500), (1500, 1500)
root = (peaks[0] ** 2 + peaks[1] ** 2) ** 0.5
total = sum(peaks)


def with_heights(of):
    return [max(5, peak + 0.003 * height) for peak, height in zip(peaks, of, strict=True)]


def by_height(of):
    return [max(5, 0.009 * height) for height in of]


def from_line(of):
    return [
        max(2 / 3 * peak, max(0.006 * height, 3) / 2) for peak, height in zip(peaks, of, strict=True)
    ]


two = {
    "srss": root,
    "share_of_sum": total,
    "asce_7": total,
    "canada": root,
    "eurocode_8": total,
    "ubc_97": total,
    "mexico_city": sum(with_heights(heights)),
    "is_1893": total,
    "taiwan": 0.6 * total,
    "peru_e030": sum(from_line(heights)),
    "asce_41": 0.04 * min(heights),
    "mexico_city_simplified": sum(by_height(heights)),
    "china_gb_50011": 10 + 2 * max(0, min(heights) - 1500) / 300,
}
one = two | {
    "asce_7": root,
    "eurocode_8": 0.7 * root,
    "ubc_97": root,
    "mexico_city": sum(with_heights(alike)) / 2,
    "peru_e030": max(0.006 * min(alike), 3, total * 2 / 3),
    "mexico_city_simplified": sum(by_height(alike)) / 2,
}
ANSWERS = {
    "gap": [gap / 100 for gap in two.values()],
    "gap_of_alike_buildings": [gap / 100 for gap in one.values()],
}
NUMBERS = {
    **{"peaks": peaks, "heights": [height / 100 for height in heights], "root": root, "total": total},
    **{"with_heights": with_heights(heights), "of_height": 0.006 * min(heights)},
    **{"by_height": by_height(heights), "share_of_height": 0.04 * min(heights)},
    **{"from_line": from_line(heights), "halved": sum(with_heights(alike)) / 2},
}
