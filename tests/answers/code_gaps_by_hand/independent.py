"""The clauses, one line each, in centimetres.

Mexico City, NTC-Sismo 1.10: every building keeps the distance from its boundary, and two keep the
sum; half of it is allowed "si los dos cuerpos tienen la misma altura y estructuración y, además,
las losas coinciden a la misma altura, en todos los niveles". IBC 2009, as ASCE 7, 12.12.3: the root
of squares for "adjacent buildings on the same property"; from a property line the own displacement.
Peru, E.030, 33.2: 2/3 of the sum, and s = 0.006 h, 0.03 m at least; 33.3: from a property line 2/3
of the own displacement, and s/2. From memory, their texts not seen: Eurocode 8, 4.4.2.7: (2) b the
root of squares within one property, a the own displacement from its line, (3) 0.7 of it for floors
at the same elevations; IS 1893 of 2016, 7.11.3: R1 d1 + R2 d2 for level floors; NZS 1170.5, 7.4.1:
the own displacement from the line. TBDY 2018, 4.9.3: 0.25 of the root of R/I times reduced
displacements for level floors, and 30 mm up to 6 m, 10 mm more for every 3 m. NTC 2018, 7.2.1: the
sum, and h/100 times 2 ag S/g, the factor 1 at most. Standard 2800: 0.005 of the height from the
boundary, up to 8 storeys. NSR-10, A.6.5.2: 0.02 of the height of the new building above three
storeys, for level floors.
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
        max(2 / 3 * peak, max(0.006 * height, 3) / 2)
        for peak, height in zip(peaks, of, strict=True)
    ]


def turkey(of):
    return max(0.25 * root, 3 + (min(of) - 600) / 300)


def italy(of):
    return max(total, min(of) / 100 * min(1, 2 * 0.25))


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
    "tbdy_2018": turkey(heights),
    "ntc_2008": italy(heights),
    "ntc_2018": italy(heights),
    "iran_2800": 0.005 * sum(heights),
    "nsr_10": 0.02 * max(heights),
    "nzs_1170_5": total,
}
one = two | {
    "asce_7": root,
    "eurocode_8": 0.7 * root,
    "ubc_97": root,
    "mexico_city": sum(with_heights(alike)) / 2,
    "peru_e030": max(0.006 * min(alike), 3, total * 2 / 3),
    "mexico_city_simplified": sum(by_height(alike)) / 2,
    "tbdy_2018": turkey(alike),
    "ntc_2008": italy(alike),
    "ntc_2018": italy(alike),
    "iran_2800": 0.005 * sum(alike),
    "nsr_10": 0.02 * max(alike),
}
ANSWERS = {
    "gap": [gap / 100 for gap in two.values()],
    "gap_of_alike_buildings": [gap / 100 for gap in one.values()],
}
NUMBERS = {
    **{"storeys": [8, 5], "pga": 0.25},
    **{
        "peaks": peaks,
        "heights": [height / 100 for height in heights],
        "root": root,
        "total": total,
    },
    **{"with_heights": with_heights(heights), "of_height": 0.006 * min(heights)},
    **{"by_height": by_height(heights), "share_of_height": 0.04 * min(heights)},
    **{"from_line": from_line(heights), "halved": sum(with_heights(alike)) / 2},
    **{"share_of_root": 0.25 * root, "least": turkey(heights), "of_pga": min(heights) / 200},
    **{"iran": [0.005 * height for height in heights], "colombia": 0.02 * max(heights)},
}
