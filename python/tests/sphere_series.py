"""Total pressure around a rigid or a soft sphere insonified by omnidirectional monopoles: the exact series.

Time factor e^{-i omega t}. A source at x_s sends e^{ikr}/r, r = |x - x_s|. With r, r_s the distances of
point and source from the centre, a the radius and gamma the angle between them (Bowman, Senior, Uslenghi,
Electromagnetic and Acoustic Scattering by Simple Shapes, 10.3; Morse and Ingard, Theoretical Acoustics,
8.2):

    total     = e^{ikR}/R - ik sum_n (2n+1) B_n h_n(kr) h_n(kr_s) P_n(cos gamma)
    B_n rigid = j_n'(ka)/h_n'(ka),    B_n soft = j_n(ka)/h_n(ka)

with R the distance between point and source. h_n overflows before the series has converged when r and r_s
are near a. So the sum uses ratios that never overflow:

    B_n h_n(kr) h_n(kr_s) = W_n [h_n(kr)/h_n(ka)] [h_n(kr_s)/h_n(ka)]
    W_n soft  = j_n h_n,      W_n rigid = j_n h_n (j_n'/j_n)/(h_n'/h_n)                     (at ka)
"""

import numpy as np
from scipy.special import spherical_jn, spherical_yn


def hankel_ratios(x, terms):
    """Returns h_n(x)/h_{n-1}(x) of spherical Hankel functions of the first kind, by a stable forward
    recurrence.

    Parameters
    ----------
    x
        (P,), above 0.
    terms
        Number of ratios.

    Returns
    -------
    (terms, P) ndarray
        Row n is h_n/h_{n-1}; row 0 is a placeholder of 1.
    """
    x = np.asarray(x, float)
    ratios = np.ones((terms, x.size), complex)
    if terms > 1:
        ratios[1] = 1 / x - 1j
    for n in range(1, terms - 1):
        ratios[n + 1] = (2 * n + 1) / x - 1 / ratios[n]
    return ratios


def surface_coefficients(x, terms, kind):
    """Returns W_n of the module's head, at x = ka.

    Up to n = x + 20 the functions themselves are used, because j_n may vanish there. Above, j_n is
    positive and h_n large: the Wronskian gives j_n h_n = (i/x^2) / (h_n'/h_n - j_n'/j_n), and a downward
    recurrence gives j_{n+1}/j_n.

    Parameters
    ----------
    x
        A number.
    terms
        Number of terms.
    kind
        "rigid" or "soft".

    Returns
    -------
    (terms,) ndarray
    """
    n = np.arange(terms)
    direct = n <= x + 20
    w = np.empty(terms, complex)

    m = n[direct]
    j, h = spherical_jn(m, x), spherical_jn(m, x) + 1j * spherical_yn(m, x)
    if kind == "soft":
        w[direct] = j * h
    else:
        dj = spherical_jn(m, x, derivative=True)
        dh = dj + 1j * spherical_yn(m, x, derivative=True)
        w[direct] = dj * h * h / dh

    up = np.zeros(terms + 61)  # j_{n+1}/j_n; after 60 additional terms the start value 0 has no effect
    for q in range(terms + 59, int(x), -1):
        up[q] = 1 / ((2 * q + 3) / x - up[q + 1])
    far = ~direct
    log_j = n[far] / x - up[n[far]]
    log_h = n[far] / x - hankel_ratios([x], terms + 1)[1:, 0][far]
    product = (1j / x**2) / (log_h - log_j)
    w[far] = product if kind == "soft" else product * log_j / log_h
    return w


def terms_needed(ratio, ka):
    """Returns the number of terms for a relative error of 1e-17; term n falls like `ratio`^-n."""
    growth = max(np.log(ratio), 1e-3)
    return int(ka + 6 * ka ** (1 / 3) + 30 + 40 / growth)


def scattered(points, sources, center, radius, k, kind):
    """Returns the scattered pressure alone; shapes and errors are those of `total`."""
    if kind not in ("rigid", "soft"):
        raise ValueError(f"kind is {kind!r}; use 'rigid' or 'soft'")
    points = np.atleast_2d(np.asarray(points, float)) - center
    sources = np.atleast_2d(np.asarray(sources, float)) - center
    r, rs = np.linalg.norm(points, axis=1), np.linalg.norm(sources, axis=1)
    if r.min() < radius * (1 - 1e-12) or rs.min() <= radius:
        raise ValueError("a point or source lies inside the sphere")
    ka = k * radius
    terms = terms_needed(r.min() * rs.min() / radius**2, ka)
    w = surface_coefficients(ka, terms, kind)
    n = np.arange(terms)
    surface = hankel_ratios([ka], terms)
    h0 = np.exp(1j * ka) / (1j * ka)
    fall = []
    for d in (r, rs):
        steps = hankel_ratios(k * d, terms) / surface
        steps[0] = np.exp(1j * k * d) / (1j * k * d) / h0
        fall.append(np.cumprod(steps, axis=0))
    at_points, at_sources = fall
    at_sources *= (w * (2 * n + 1))[:, None]

    cosine = np.clip((sources / rs[:, None]) @ (points / r[:, None]).T, -1, 1)
    before, legendre = np.zeros_like(cosine), np.ones_like(cosine)
    result = np.zeros(cosine.shape, complex)
    for q in range(terms):
        result += np.outer(at_sources[q], at_points[q]) * legendre
        before, legendre = legendre, ((2 * q + 1) * cosine * legendre - q * before) / (q + 1)
    return -1j * k * result


def total(points, sources, center, radius, k, kind):
    """Returns the total pressure of unit monopoles e^{ikr}/r beside a sphere.

    Parameters
    ----------
    points
        (P, 3) in m, outside the sphere or on it.
    sources
        (N, 3) in m, outside.
    center
        (3,) in m.
    radius
        In m.
    k
        Wavenumber in rad/m.
    kind
        "rigid" (dp/dn = 0) or "soft" (p = 0).

    Returns
    -------
    (N, P) ndarray
        In 1/m; multiply it by the source's pressure P0 in Pa m.

    Raises
    ------
    ValueError
        If a point or source is inside the sphere, or if the kind is another one.
    """
    points, sources = np.atleast_2d(points), np.atleast_2d(sources)
    distance = np.linalg.norm(sources[:, None] - points[None], axis=2)
    return np.exp(1j * k * distance) / distance + scattered(points, sources, center, radius, k, kind)
