"""Quantities of the columns of files, and the words by which titles name them in several languages."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from stochlin.models.units import size_of


@dataclass(frozen=True)
class Quantity:
    """What a column may hold, by its name with an article; ``unit`` is the one in which it is read."""

    name: str
    unit: str = ""  # empty of what is no measured quantity
    usual: str = ""  # unit of numbers whose file states none; empty if it is asked for

    def size(self, unit: str) -> float | None:
        """The size of a unit in that of the quantity; None if it is none of this quantity."""
        return _OF_FREQUENCIES.get(unit.strip().lower(), {}).get(self.unit) or size_of(unit, self.unit)


# Sizes that powers of seconds do not tell apart.
_SIZES = {"Hz": {"Hz": 1.0, "rad/s": math.tau}, "rad/s": {"Hz": 1 / math.tau, "rad/s": 1.0}}
_SIZES["1/s"] = {"Hz": 1.0, "rad/s": 1.0}
_SPELLED = {
    "Hz": ("hz", "hertz", "cps", "cycles/s", "cycles/sec"),
    "rad/s": ("rad/s", "rad/sec", "rad s-1", "rad s^-1", "rad/sn"),
    "1/s": ("1/s", "s-1", "s^-1", "1/sec"),
}
_OF_FREQUENCIES = {name: _SIZES[unit] for unit, names in _SPELLED.items() for name in names}

PERIOD = Quantity("a period", "s", "s")
FREQUENCY = Quantity("a frequency", "Hz", "Hz")
ANGULAR = Quantity("an angular frequency", "rad/s", "rad/s")
TIME = Quantity("a time", "s", "s")
ACCELERATION = Quantity("an acceleration", "m/s^2")
SPECTRAL = Quantity("a spectral acceleration", "m/s^2")
PEAK = Quantity("a peak ground acceleration", "m/s^2")
VELOCITY = Quantity("a velocity", "m/s")
PSEUDO_VELOCITY = Quantity("a pseudo-velocity", "m/s")
DISPLACEMENT = Quantity("a displacement", "m")
SPECTRAL_DISPLACEMENT = Quantity("a spectral displacement", "m")
FORCE = Quantity("a force", "N")
RATE = Quantity("an annual frequency", "1/yr", "1/yr")
PROBABILITY = Quantity("a probability", "1", "1")
RETURN_PERIOD = Quantity("a return period", "yr", "yr")
LEVEL = Quantity("an intensity")
DAMPING = Quantity("a damping ratio", "1", "1")
INDEX = Quantity("an index")
MODE = Quantity("the number of a mode")
NAME = Quantity("a name")
OTHER = Quantity("another quantity")
STRANGE = Quantity("in a unit of another quantity")

# Words as they are compared: small letters without accents, several words as one. A word of a single
# letter is known where it is the whole title.
TABLE: Mapping[Quantity, str] = {
    PERIOD: """t tn period periods naturalperiod spectralperiod periodo periodos periodi periode
        periodes periodedevibration schwingungsdauer schwingzeit eigenperiode periyot periyotlar
        periyod dogalperiyot titresimperiyodu""",
    FREQUENCY: """f fn hz freq freqs frequency frequencies naturalfrequency frecuencia
        frecuencias frequenza frequenze frequences frequence frequenz frequenzen eigenfrequenz
        frekans frequencia frequencias""",
    ANGULAR: """w ω omega omegan wn circularfrequency angularfrequency circularfreq angularfreq
        pulsation pulsacion pulsazione pulsacao frecuenciaangular frecuenciacircular
        frequenzaangolare frequenceangulaire frequenciaangular kreisfrequenz acisalfrekans
        dairesel""",
    TIME: """t time times elapsedtime timestamp date datetime tiempo fecha tempo temps zeit
        datum zaman sure tarih""",
    ACCELERATION: """a ax ay az acc accel acceleration accelerations groundacceleration
        accelerogram acel aceleracion aceleraciones acelerograma acelerogramas accelerazione
        accelerazioni accelerogramma accelerogramme accelerogrammes beschl beschleunigung
        beschleunigungen ivme ivmeler akselerasyon aceleracao aceleracoes""",
    SPECTRAL: """sa sae se psa sd spectralacceleration spectralaccel spectralacc
        pseudoacceleration pseudospectralacceleration responsespectrum aceleracionespectral
        pseudoaceleracion accelerazionespettrale pseudoaccelerazione accelerationspectrale
        spektralbeschleunigung pseudobeschleunigung spektralivme aceleracaoespectral
        pseudoaceleracao""",
    PEAK: """pga ag agr agmax amax peakgroundacceleration peakacceleration aceleracionmaxima
        aceleracionpico accelerazionedipicco accelerazionemassima accelerationmaximale
        spitzenbeschleunigung bodenbeschleunigung enbuyukyerivmesi aceleracaomaxima
        aceleracaodepico""",
    VELOCITY: """v sv vel pgv velocity velocities spectralvelocity peakgroundvelocity velocidad
        velocidades velocidadespectral velocita velocitaspettrale vitesse vitesses
        vitessespectrale geschwindigkeit spektralgeschwindigkeit hiz hizlar spektralhiz
        velocidade velocidades""",
    PSEUDO_VELOCITY: """psv pseudovelocity pseudospectralvelocity spectralpseudovelocity
        pseudovelocidad pseudovelocita pseudovitesse pseudogeschwindigkeit pseudohiz sozdehiz
        pseudovelocidade""",
    DISPLACEMENT: """d u ux uy uz pgd disp displ displacement displacements deformation roof
        roofdisplacement desp desplazamiento desplazamientos techo azotea spostamento
        spostamenti deplacement deplacements verschiebung verschiebungen verformung
        yerdegistirme deplasman deslocamento deslocamentos""",
    SPECTRAL_DISPLACEMENT: """sd psd sde spectraldisplacement pseudodisplacement
        desplazamientoespectral spostamentospettrale deplacementspectral spektralverschiebung
        spektralyerdegistirme deslocamentoespectral""",
    FORCE: """f v vb fb force forces shear baseshear baseforce basereaction fuerza fuerzas
        cortante cortantebasal cortanteenlabase forza forze taglio taglioallabase cisaillement
        efforttranchant kraft querkraft fundamentschub kuvvet kesmekuvveti tabankesmekuvveti
        forca cisalhamento cortantenabase""",
    RATE: """f λ lambda rate rates afe mafe aef freq frequency frequencies annual annualrate
        annualfrequency annualfreq annualfrequencyofexceedance annualrateofexceedance
        exceedancerate rateofexceedance frequencyofexceedance peryear peryr frecuencia
        frecuenciaanual frecuenciaanualdeexcedencia tasa tasaanual tasaanualdeexcedencia
        tasadeexcedencia frequenza frequenzaannua tassoannuo frequence frequenceannuelle
        tauxannuel frequenz jahrlichefrequenz uberschreitungsrate uberschreitungshaufigkeit
        frekans yillikfrekans yillikasilmasikligi frequencia frequenciaanual taxaanual
        taxadeexcedencia""",
    PROBABILITY: """p prob poe apoe probability probabilities probabilityofexceedance exceedance
        exceedanceprobability annualprobability annualprobabilityofexceedance probabilidad
        probabilidaddeexcedencia probabilita probabilitadieccedenza probabilite
        probabilitededepassement wahrscheinlichkeit uberschreitungswahrscheinlichkeit olasilik
        asilmaolasiligi probabilidade probabilidadedeexcedencia""",
    RETURN_PERIOD: """tr rp mri returnperiod recurrenceinterval periododeretorno tempodiritorno
        periodediretorno periododiritorno periodederetour wiederkehrperiode tekrarlanmaperiyodu
        donusperiyodu tempoderetorno""",
    LEVEL: """im iml level intensity intensitymeasure intensitymeasurelevel s0 intensidad
        intensita intensite intensitat siddet intensidade""",
    DAMPING: """ξ ζ xi zeta damping dampingratio amortiguamiento smorzamento amortissement
        dampfung dampfungsmass sonum sonumorani amortecimento""",
    INDEX: """no nr num number index idx id point pt punto numero numer nummer sira sirano row
        line item obs nokta ordine""",
    MODE: "mode modo moda modes modenumber modeno mod eigenmode",
    NAME: """name nombre nome nom ad isim bezeichnung case outputcase loadcase function label
        story station""",
    OTHER: """powerspectraldensity fourier fas fourieramplitude energy distance jerk
        strain stress arias husid cav temperature""",
}
_WORDS = {of: frozenset(words.split()) for of, words in TABLE.items()}
QUANTITIES: Mapping[str, tuple[Quantity, ...]] = {
    word: tuple(of for of, words in _WORDS.items() if word in words)
    for word in frozenset[str]().union(*_WORDS.values())
}
