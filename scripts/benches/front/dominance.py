"""Which points of time and error are dominated: another has less of both."""

TIME_SPREAD = 0.05  # relative difference of two times that repeated runs show


def dominates(a, b):
    """a, b: (seconds, error). Errors are the same in every run, times are not."""
    return a[0] < b[0] * (1.0 - TIME_SPREAD) and a[1] < b[1]


def dominator(point, others):
    """The index of the point among `others` that is better by the largest product of ratios; None if none dominates."""
    better = [i for i, other in enumerate(others) if dominates(other, point)]
    return min(better, key=lambda i: others[i][0] * others[i][1], default=None)


def front(points):
    """The indices of points that no other point undercuts in error at the same or less time, by time."""
    found, least = [], float("inf")
    for index in sorted(range(len(points)), key=lambda i: points[i]):
        if points[index][1] < least:
            found.append(index)
            least = points[index][1]
    return found
