"""Points of the trade: what one method costs and reaches at one sample count, on one scene or on all in geometric mean."""

from dataclasses import asdict, dataclass

from benches.front.dominance import dominator, front
from benches.front.plain_curve import PlainCurve
from benches.geometric_mean import geometric_mean

METRICS = {"relmse": "relMSE", "temporal": "temporal error"}
MEAN = "geometric mean"


def positive_errors(mean):
    """Of the means of `becalm compare`; None: not above zero, as an estimate from noisy references may be, or not known."""
    return {metric: value if (value := mean[metric]) is not None and value > 0.0 else None for metric in METRICS}


@dataclass(frozen=True)
class Point:
    spp: int
    name: str
    title: str
    kind: str                # "plain", "preset", "setting" or "recipe"
    render_s: float | None   # a frame; None: not known
    denoise_s: float         # likewise
    relmse: float | None     # None: not above zero in all scenes of a mean
    temporal: float | None

    @property
    def label(self):
        return f"{self.spp} spp" + ("" if self.kind == "plain" else f" + {self.title}")

    @property
    def seconds(self):
        """Of rendering and denoising; where rendering is not known, of denoising."""
        return (self.render_s or 0.0) + self.denoise_s


@dataclass(frozen=True)
class Worth:
    """What plain rendering needs for the error of a point."""
    samples: float
    is_measured: bool           # not extrapolated
    times: float | None         # the time of plain rendering over the point's
    at_equal_time: float | None # the point's error over that of plain rendering in the same time


class Trade:
    """The points of one scene, or the means of several."""

    def __init__(self, title, points):
        self.title, self.points = title, points
        self.has_render_time = all(point.render_s is not None for point in points)

    def plain(self):
        return [point for point in self.points if point.kind == "plain"]

    def comparable(self, metric, spp=None):
        """The points that have the error and a time, and this sample count if one is given."""
        return [p for p in self.points if getattr(p, metric) is not None and p.seconds > 0.0 and spp in (None, p.spp)]

    def front(self, metric):
        points = self.comparable(metric)
        return [points[i] for i in front([(p.seconds, getattr(p, metric)) for p in points])]

    def dominator(self, point, metric):
        """The point that dominates this one, or None. Equal sample counts are compared by the time of denoising: that of rendering is
        the same and would hide the difference. Others are compared by both together, if the time of rendering is known."""
        def share(other):
            return other.denoise_s / point.denoise_s if other.spp == point.spp else other.seconds / point.seconds

        others = self.comparable(metric, None if self.has_render_time else point.spp)
        index = dominator((1.0, getattr(point, metric)), [(share(other), getattr(other, metric)) for other in others])
        return None if index is None else others[index]

    def curve(self, metric):
        """The curve of plain rendering; None if nothing of it is measured above zero."""
        errors = {p.spp: error for p in self.plain() if (error := getattr(p, metric)) is not None}
        seconds = {p.spp: p.render_s for p in self.plain()} if self.has_render_time else {}
        return PlainCurve(errors, seconds) if errors else None

    def worth(self, point, metric):
        """None if there is no curve or no error."""
        curve, error = self.curve(metric), getattr(point, metric)
        if curve is None or error is None:
            return None
        samples = curve.samples(error)
        seconds, equal = curve.seconds(samples), curve.samples_in(point.seconds)
        return Worth(samples, curve.is_measured(samples), seconds and seconds / point.seconds, equal and error / curve.error(equal))

    def figures(self):
        """All of it for a JSON file."""
        def of(point):
            return asdict(point) | {metric: {"error": getattr(point, metric), "worth": (w := self.worth(point, metric)) and asdict(w),
                                             "dominated_by": self._dominated_by(point, metric)} for metric in METRICS}
        return {"title": self.title, "points": [of(point) for point in self.points]}

    def _dominated_by(self, point, metric):
        if getattr(point, metric) is None or point.denoise_s <= 0.0:
            return None
        found = self.dominator(point, metric)
        return found and found.label


def mean_trade(trades):
    """The geometric means over the scenes, of the points that all scenes have."""
    by_key = [{(p.spp, p.name): p for p in trade.points} for trade in trades]
    points = []
    for key, point in by_key[0].items():
        same = [points_of.get(key) for points_of in by_key]
        if None not in same:
            points.append(Point(point.spp, point.name, point.title, point.kind, _mean(same, "render_s"), _mean(same, "denoise_s") or 0.0,
                                _mean(same, "relmse"), _mean(same, "temporal")))
    return Trade(MEAN, points)


def _mean(points, field):
    return geometric_mean([getattr(point, field) for point in points])


def mean_worth(trades, point, metric):
    """The geometric means of what plain rendering needs, over the scenes; measured only if it is in each of them. None if one has none."""
    found = [trade.worth(same, metric) for trade in trades for same in trade.points if (same.spp, same.name) == (point.spp, point.name)]
    if len(found) < len(trades) or None in found:
        return None
    return Worth(_mean(found, "samples"), all(worth.is_measured for worth in found), _mean(found, "times"), _mean(found, "at_equal_time"))
