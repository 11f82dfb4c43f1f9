"""Double-precision reference for the solution methods, written from their definitions.

G (M, N) is the propagation matrix in the paper's unit (distances in mm, P0 = 1), t (M,) are the targets;
all weights are 1. Nothing is rearranged for speed: an N x N system of a method is solved as an N x N
system.
"""

import clarabel
import numpy as np
import scipy.linalg
import scipy.optimize
import scipy.sparse
from numpy.typing import NDArray

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]


def limited(q: Complex, limit: str) -> Complex:
    """Returns the drive q limited to |q| <= 1 by one of three rules."""
    size = np.abs(q)
    return q / {"clamp": np.maximum(size, 1), "normalize": size.max(), "full": size}[limit]


def turned(t: Real, p: Complex) -> Complex:
    """Returns the targets t with the phases of the pressures p."""
    return t * p / np.abs(p)


def tikhonov(G: Complex, t: Real, regularization: float = 0.07, limit: str = "clamp") -> Complex:
    """Returns the drive of Tikhonov's regularised pseudo-inverse, for targets of phase 0."""
    H = G @ G.conj().T
    mu = regularization * np.mean(np.diag(H).real)
    return limited(G.conj().T @ np.linalg.solve(H + mu * np.eye(len(t)), t), limit)


def evd(G: Complex, t: Real, gamma: float = 1.0, limit: str = "clamp") -> Complex:
    """Returns the drive of the eigenvector method of Long et al. 2014."""
    power = np.sum(np.abs(G) ** 2, axis=1)
    R = np.array([[np.sum(g * h.conj()) * a / e for h, a, e in zip(G, t, power, strict=True)] for g in G])
    values, vectors = np.linalg.eig(R)
    p = turned(t, vectors[:, np.argmax(values.real)])
    w = np.sqrt(np.mean(t[:, None] * np.abs(G), axis=0)) ** gamma
    q = scipy.linalg.solve(G.conj().T @ G + np.diag(w**2), G.conj().T @ p, assume_a="pos")
    return limited(q, limit)


def gs(G: Complex, t: Real, steps: int = 100) -> Complex:
    """Returns the drive of the Gerchberg-Saxton algorithm with |q| = 1, started from q = 1."""
    q = np.ones(G.shape[1], complex)
    for _ in range(steps):
        q = limited(G.conj().T @ turned(t, G @ q), "full")
    return q


def gspat(G: Complex, t: Real, steps: int = 100, limit: str = "clamp") -> Complex:
    """Returns the drive of GS-PAT, Plasencia et al. 2020."""
    X = G.conj().T / np.sum(np.abs(G) ** 2, axis=1)
    R = G @ X
    p = t.astype(complex)
    for _ in range(steps):
        p = turned(t, R @ p)
    g = R @ p
    return limited(X @ (t**2 * g / np.abs(g) ** 2), limit)


def sdp_parts(G: Complex, t: Real, alpha: float = 1e-3) -> tuple[Complex, Complex]:
    """Returns the regularised inverse G^+ and the matrix Q of Inoue et al. 2015.
    u^H Q u is the cost of the points' phases u, which are numbers of modulus 1.
    """
    M = len(t)
    inverse = G.conj().T @ np.linalg.inv(G @ G.conj().T + alpha * np.eye(M))
    return inverse, t[:, None] * (np.eye(M) - G @ inverse) * t


def descend(Q: Complex, rng: np.random.Generator, steps: int = 1000, scale: float = 0.9) -> Complex:
    """Returns a semidefinite X with unit diagonal and small tr(Q X), by coordinate descent from X = 1."""
    M = len(Q)
    X = np.eye(M, dtype=complex)
    for i in rng.integers(M, size=steps):
        m = Q[:, i].copy()
        m[i] = 0
        x = X @ m
        g = np.vdot(x, m).real
        x = -np.sqrt(scale / g) * x if g > 0 else np.zeros(M, complex)
        x[i] = 1
        X[:, i], X[i] = x, x.conj()
    return X


def leading(X: Complex) -> Complex:
    """Returns the eigenvector of a Hermitian matrix for its largest eigenvalue."""
    return np.linalg.eigh(X)[1][:, -1]


def sdp(
    G: Complex,
    t: Real,
    rng: np.random.Generator,
    *,
    steps: int = 1000,
    scale: float = 0.9,
    moduli: str = "raw",
    limit: str = "normalize",
) -> Complex:
    """Returns the drive of the method of Inoue et al. 2015; `scale` is the option lambda."""
    inverse, Q = sdp_parts(G, t)
    u = leading(descend(Q, rng, steps, scale))
    return limited(inverse @ (t * (u if moduli == "raw" else np.exp(1j * np.angle(u)))), limit)


def relaxed(Q: Complex) -> tuple[float, Complex]:
    """Returns the least Re tr(Q X) over semidefinite X with unit diagonal, and this X, by an interior-point
    method.

    A Hermitian X = A + jB is semidefinite exactly if the real matrix [[A, -B], [B, A]] is semidefinite.
    Clarabel expects the upper triangle of this matrix, by columns, with off-diagonal entries times sqrt 2.
    """
    M = len(Q)
    n = 2 * M
    cost = np.block([[Q.real, -Q.imag], [Q.imag, Q.real]]) / 2
    rows, columns = np.array([(r, c) for c in range(n) for r in range(c + 1)]).T
    index = {pair: k for k, pair in enumerate(zip(rows.tolist(), columns.tolist(), strict=True))}
    weight = np.where(rows == columns, 1.0, np.sqrt(2.0))
    size = len(rows)
    # First the equality constraints on the entries x: unit diagonal, the same A in both corners, B = -B^T.
    equal, right = [], []
    for j in range(M):
        for k in range(j, M):
            equal.append({index[j, k]: 1.0, index[M + j, M + k]: -1.0})
            equal.append({index[j, M + k]: 1.0, **({index[k, M + j]: 1.0} if k > j else {})})
            right += [0.0, 0.0]
        equal.append({index[j, j]: 1.0})
        right.append(1.0)
    top = scipy.sparse.lil_matrix((len(equal), size))
    for row, entries in enumerate(equal):
        for column, value in entries.items():
            top[row, column] = value
    A = scipy.sparse.vstack([top, scipy.sparse.diags(-weight)]).tocsc()
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    cones = [clarabel.ZeroConeT(len(equal)), clarabel.PSDTriangleConeT(n)]
    c = np.where(rows == columns, 1.0, 2.0) * cost[rows, columns]
    b = np.concatenate([right, np.zeros(size)])
    answer = clarabel.DefaultSolver(scipy.sparse.csc_matrix((size, size)), c, A, b, cones, settings).solve()
    assert str(answer.status) == "Solved"
    whole = np.zeros((n, n))
    whole[rows, columns] = whole[columns, rows] = answer.x
    return answer.obj_val, whole[:M, :M] + 1j * whole[M:, :M]


def lm_residuals(G: Complex, t: Real, x: Real) -> tuple[Complex, Complex]:
    """Returns sum_i G_ji e^{j phi_i} - t_j e^{j theta_j} for x = (phi, theta),
    and its derivatives (M, N + M).
    """
    N = G.shape[1]
    waves, wanted = G * np.exp(1j * x[:N]), t * np.exp(1j * x[N:])
    return waves.sum(axis=1) - wanted, 1j * np.hstack([waves, -np.diag(wanted)])


def lm(G: Complex, t: Real, start: Real, *, steps: int = 200, tau: float = 1e-3, eps: float = 1e-8) -> Complex:
    """Returns the drive with |q| = 1 of the Levenberg-Marquardt algorithm, from the phases `start`.
    It is algorithm 3.16 of Madsen, Nielsen and Tingleff 2004.
    """

    def parts(x: Real) -> tuple[Real, Real]:
        f, J = lm_residuals(G, t, x)
        return np.concatenate([f.real, f.imag]), np.vstack([J.real, J.imag])

    x = start
    f, J = parts(x)
    mu, nu = tau * np.max(np.sum(J**2, axis=0)), 2.0
    for _ in range(steps):
        slope = J.T @ f
        if np.abs(slope).max() <= eps:
            break
        # The step solves (J^T J + mu I) step = -J^T f.
        step = -J.T @ np.linalg.solve(J @ J.T + mu * np.eye(len(f)), f)
        if np.linalg.norm(step) <= eps * (np.linalg.norm(x) + eps):
            break
        f_new, J_new = parts(x + step)
        gain = (f @ f - f_new @ f_new) / (step @ (mu * step - slope))
        if gain > 0:
            x, f, J = x + step, f_new, J_new
            mu, nu = mu * max(1 / 3, 1 - (2 * gain - 1) ** 3), 2.0
        else:
            mu, nu = mu * nu, 2 * nu
    return np.exp(1j * x[: G.shape[1]])


def least_squares(G: Complex, t: Real, start: Real, evaluations: int) -> Complex:
    """Returns the drive that minimises the cost of `lm_residuals`, by SciPy's trust-region method."""

    def value(x: Real) -> Real:
        f = lm_residuals(G, t, x)[0]
        return np.concatenate([f.real, f.imag])

    def slope(x: Real) -> Real:
        J = lm_residuals(G, t, x)[1]
        return np.vstack([J.real, J.imag])

    found = scipy.optimize.least_squares(value, start, slope, method="trf", max_nfev=evaluations)
    return np.exp(1j * found.x[: G.shape[1]])
