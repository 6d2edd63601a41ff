"""Small record and hazard files, written by hand after the documentation of each format."""

import json
from collections.abc import Sequence

Numbers = Sequence[float]
# Words for a vertical component, as networks and people write them.
VERTICAL = [
    *(
        "BHZ",
        "BHZ00",
        "HNZ",
        "HNZ10",
        "HGZ",
        "ENZ",
        "VRT",
        "VTC",
        "VT",
        "VER",
        "Vert",
        "VERTICAL",
        "V",
        "V1",
    ),
    *(
        "Z",
        "Z00",
        "ZUP",
        "U",
        "UD",
        "UD2",
        "U-D",
        "UP",
        "Up",
        "DN",
        "DWN",
        "Down",
        "UPDOWN",
        "Düşey",
    ),
]


def rows(values: Numbers, per_line: int, form: str) -> str:
    """Numbers in lines of some each, as a Fortran format writes them."""
    lines = (values[n : n + per_line] for n in range(0, len(values), per_line))
    return "\n".join("".join(form.format(value) for value in line) for line in lines)


def knet(
    counts: Numbers, scale: str = "3920(gal)/6182761", rate: str = "100Hz", memo: str = ""
) -> str:
    """K-NET: counts of one component; the duration gives their number."""
    duration = len(counts) / float(rate.rstrip("Hz "))
    head = [
        ("Origin Time", "2006/01/18 23:25:00"),
        ("Lat.", "37.798"),
        ("Long.", "142.200"),
        ("Depth. (km)", "36"),
        ("Mag.", "5.7"),
        ("Station Code", "MYG002"),
        ("Station Lat.", "38.7262"),
        ("Station Long.", "141.5109"),
        ("Station Height(m)", "-9999"),
        ("Record Time", "2006/01/18 23:25:46"),
        ("Sampling Freq(Hz)", rate),
        ("Duration Time(s)", f"{duration:g}"),
        ("Dir.", "N-S"),
        ("Scale Factor", scale),
        ("Max. Acc. (gal)", "48.060"),
        ("Last Correction", "2006/01/18 23:25:31"),
        ("Memo.", memo),
    ]
    lines = [f"{label:18}{text}" for label, text in head]
    return "\n".join([*lines, rows(counts, 8, "{:9.0f}")]) + "\n"


def esm(values: Numbers, units: str = "cm/s^2", baseline: str = "BASELINE REMOVED") -> str:
    """ESM: one value a line below 64 lines ``KEY: value``, of which the essential ones are here."""
    head = {
        "EVENT_NAME": "SOMEWHERE",
        "EVENT_ID": "EMSC-20190728_0000106",
        "EVENT_TIME_HHMMSS": "23:08:25.75",
        "MAGNITUDE_W": "",
        "STATION_CODE": "ARS1",
        "VS30_M/S": "",
        "SAMPLING_INTERVAL_S": "0.005000",
        "NDATA": f"{len(values)}",
        "STREAM": "HNE",
        "UNITS": units,
        "INSTRUMENT": "sensor = A [Unknown] | digitizer = B: 2 [Unknown]",
        "PGA_CM/S^2": "0.300022",
        "BASELINE_CORRECTION": baseline,
        "DATA_TYPE": "ACCELERATION",
        "USER1": "processing.py: 100 % of it # done",
        "USER5": "",
    }
    lines = [f"{key}: {text}" for key, text in head.items()]
    return "\n".join([*lines, *(f"{value:.6f}" for value in values)]) + "\n"


def unam(channels: Sequence[Numbers], names: str = "/V/N00E/N90E", digits: int = 4) -> str:
    """Standard file of UNAM, version 2.0: a column for each channel below titles in Spanish."""
    count, number, step = len(channels[0]), len(channels), 0.005
    rule = "---------+" * 8
    head = f"""\
{"*" * 86}
                       INSTITUTO DE INGENIERIA, UNAM
                   Coordinacion de Ingenieria Sismologica
           Ciudad Universitaria, Coyoacan, Mexico D.F., C.P. 04510
{"*" * 86}
ARCHIVO ESTANDAR DE ACELERACION:
VERSION DEL FORMATO                    : 2.0

{"=" * 80}
DATOS DE LA ESTACION:
NOMBRE DE LA ESTACION                  : LAS CA&AS
CLAVE DE LA ESTACION                   : CANA
COORDENADAS DE LA ESTACION             : 16.84851 LAT. N
                                       : 99.85157 LONG. W
NUMERO DE CANALES                      : {number}
ORIENTACION C1-C6 (rumbo;orientacion)  : {names}
ORIENTACION C7-C12 (rumbo;orientacion) :
INTERVALO DE MUESTREO, C1-C6 (s)       : {f"/{step:g}" * number}
INTERVALO DE MUESTREO, C7-C12 (s)      :
FECHA DEL SISMO [GMT]                  : 2017/09/19
HORA EPICENTRO (GMT)                   : 18:14:40
De http://www.ssn.unam.mx, el 15/11/2018
DURACION DEL REGISTRO (s), C1-C6       : {f"/{count * step:.2f}" * number}
NUM. TOTAL DE MUESTRAS, C1-C6          : {f"/{count}" * number}
NUM. TOTAL DE MUESTRAS, C7-C12         :
UNIDADES DE LOS DATOS                  : Gal (cm/s/s)
FORMATO DATOS (FORTRAN,10 campos/dato) : {number}F10.{digits}

COMENTARIOS:

{"=" * 80}
DATOS DE ACELERACION:
{rule}
{"".join(f"   CANAL-{n}" for n in range(1, number + 1))}
{"".join(f"{name:>10}" for name in names.strip("/").split("/"))}
{rule}
"""
    lines = (
        "".join(f"{value:10.{digits}f}" for value in line) for line in zip(*channels, strict=True)
    )
    return head + "\n".join(lines) + "\n"


def csmip(
    channels: dict[str, Numbers],
    units: str = "in cm/sec2. (8f10.5)",
    step: str = ".020",
    digits: int = 5,
) -> str:
    """CSMIP Volume 2: channels one by one, with acceleration, velocity and displacement."""
    parts = []
    for n, (name, values) in enumerate(channels.items(), 1):
        what = f"{len(values):6d} points of {{}} data equally spaced at  {step} sec, "
        parts += [
            f"Corrected accelerogram   15481673.CI.WLT.--.HN      Chan  {n}:  {name}     from   ",
            "Uncorrected Accelerogram Data             Processed: 04/30/14, CGS  ciwlt1      ",
            f"{len(values):6d} points of instrument- and baseline-corrected "
            "accel, veloc and displ data",
            "    1  100    1    3    3  100 -999    3    1    0 -999 4310    050660   41    0",
            "  .0050000  .7071000 301.30000  .0038554-999.00000 4996.0580  .0861213 14.830000",
            f"{what.format('accel')}{units}    ",
            rows(values, 8, f"{{:10.{digits}f}}"),
            f"{what.format('veloc')}in cm/sec.  (8f10.7)    ",
            rows([9.0] * len(values), 8, "{:10.7f}"),
            f"{what.format('displ')}in cm.      (8f10.7)    ",
            rows([8.0] * len(values), 8, "{:10.7f}"),
            f"/&  ----------  End of data for channel  {n}  ----------",
        ]
    return "\n".join(parts) + "\n"


def cosmos(
    channels: dict[str, Numbers], units: str = "cm/sec2(04)", step: float = 10.0, digits: int = 5
) -> str:
    """COSMOS 1.20: a header of text, whole and real numbers, comments, a series per channel."""
    parts = []
    for n, (name, values) in enumerate(channels.items(), 1):
        reals = [-999.0] * 100
        reals[33], reals[61], reals[62] = 0.005, step, len(values) * step / 1000
        parts += [
            "Corrected acceleration    (Format v01.20 with 13 text lines) Src: file.txt",
            "Somewhere in California                 June 16,2005 13:53 PDT",
            "Hypocenter: 34.0580  -117.0110  H= 12km(SCSN) ML=4.9, Mw=4.8(CIT)",
            *(["Statn No: 01-23075  Code:CE-J2236  CDMG Yucaipa"] * 5),
            f"Sta Cha:  {n}: {name} (Rcrdr Chan  {n}) Location: on the ground",
            *(["Raw record length = 70.000  sec"] * 4),
            " 100 Integer-header values follow on  10 lines, Format= (10I8)",
            *(["    -999" * 10] * 10),
            " 100 Real-header values follow on  17 lines, Format= (6F13.6)",
            rows(reals, 6, "{:13.6f}"),
            '   1 Comment line(s) follow, each starting with a "|":',
            "| Sensor: KINEMETRICS EPISENSOR ES-T",
            f"{len(values):7d}  acceleration pts, approx 70 secs, "
            f"units={units},Format=(8F10.{digits})",
            rows(values, 8, f"{{:10.{digits}f}}"),
            f"End-of-data for Chan {n} acceleration",
        ]
    return "\n".join(parts) + "\n"


def openquake(
    levels: Numbers,
    sites: dict[tuple[float, float], Numbers],
    measure: str = "PGA",
    years: str = "investigation_time=50.0, ",
) -> str:
    """OpenQuake: probabilities of exceedance, a row for each site, below a comment and names."""
    comment = f"generated_by='OpenQuake engine 3.18.0', kind='mean', {years}imt='{measure}'"
    names = ["lon", "lat", "depth", *(f"poe-{level:.7f}" for level in levels)]
    lines = [
        ",".join([f"{lon:.5f}", f"{lat:.5f}", "0.00000", *(f"{value:.6E}" for value in values)])
        for (lon, lat), values in sites.items()
    ]
    return "\n".join([f'#,,,,,"{comment}"', ",".join(names), *lines]) + "\n"


def usgs(curves: dict[str, tuple[Numbers, Numbers]]) -> str:
    """USGS: the response of its hazard service, the total beside another component."""
    parts = [
        {
            "imt": {"display": name, "value": name},
            "data": [
                {"component": "Grid", "values": {"xs": [1.0, 2.0], "ys": [1e-9, 1e-10]}},
                {"component": "Total", "values": {"xs": [*xs], "ys": [*ys]}},
            ],
        }
        for name, (xs, ys) in curves.items()
    ]
    metadata = {"xlabel": "Ground Motion (g)", "ylabel": "Annual Frequency of Exceedence"}
    return json.dumps(
        {"status": "success", "response": {"metadata": metadata, "hazardCurves": parts}}
    )


def usgs_before_2022(text: str) -> str:
    """The same curves as the USGS wrote them before 2022: one axis for all parts."""
    response = json.loads(text)["response"]
    curves = [
        {
            "metadata": {
                "imt": curve["imt"],
                **response["metadata"],
                "xvalues": part["values"]["xs"],
            },
            "data": [
                {"component": "Grid", "yvalues": [0.0 for _ in part["values"]["xs"]]},
                {"component": "Total", "yvalues": part["values"]["ys"]},
            ],
        }
        for curve in response["hazardCurves"]
        for part in curve["data"]
        if part["component"] == "Total"
    ]
    return json.dumps({"status": "success", "response": curves})
