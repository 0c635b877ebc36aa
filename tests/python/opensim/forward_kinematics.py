# SPDX-License-Identifier: Apache-2.0
"""Forward kinematics of a model file in plain numpy: an evaluation that shares nothing with the importer."""

import numpy as np


def simm_spline(x, y, at):
    """Forsythe, Malcolm & Moler's cubic spline: third derivatives at the ends from four points; straight beyond."""
    n = len(x)
    h, slope = np.diff(x), np.diff(y) / np.diff(x)
    b, c, d = np.zeros(n), np.zeros(n), np.zeros(n)
    if n == 2:
        return y[0] + slope[0] * (at - x[0])
    # σ solves a tridiagonal system; its ends are the third divided differences there.
    matrix, right = np.zeros((n, n)), np.zeros(n)
    for i in range(1, n - 1):
        matrix[i, i - 1 : i + 2] = h[i - 1], 2 * (h[i - 1] + h[i]), h[i]
        right[i] = slope[i] - slope[i - 1]
    matrix[0, :2], matrix[-1, -2:] = (-h[0], h[0]), (h[-1], -h[-1])
    if n > 3:
        second = np.diff(slope) / (x[2:] - x[:-2])
        right[0] = h[0] ** 2 * (second[1] - second[0]) / (x[3] - x[0])
        right[-1] = -(h[-1] ** 2) * (second[-1] - second[-2]) / (x[-1] - x[-4])
    sigma = np.linalg.solve(matrix, right)
    b[:-1] = slope - h * (sigma[1:] + 2 * sigma[:-1])
    b[-1] = slope[-1] + h[-1] * (sigma[-2] + 2 * sigma[-1])
    c, d[:-1] = 3 * sigma, np.diff(sigma) / h
    if at <= x[0]:
        return y[0] + b[0] * (at - x[0])
    if at >= x[-1]:
        return y[-1] + b[-1] * (at - x[-1])
    i = np.searchsorted(x, at, side="right") - 1
    t = at - x[i]
    return y[i] + t * (b[i] + t * (c[i] + t * d[i]))


def function_value(function, at):
    kind = function["kind"]
    if kind == "linear":
        return function["slope"] * at + function["intercept"]
    if kind == "polynomial":
        return np.polyval(function["coefficients"][::-1], at)
    x, y = np.array(function["x"]), np.array(function["y"])
    if kind == "simm_spline":
        return simm_spline(x, y, at)
    assert kind == "piecewise_linear"
    i = np.clip(np.searchsorted(x, at) - 1, 0, len(x) - 2)
    return y[i] + (y[i + 1] - y[i]) / (x[i + 1] - x[i]) * (at - x[i])


def rotation(axis, angle):
    a = np.array(axis) / np.linalg.norm(axis)
    K = np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def frame(description):
    X = np.eye(4)
    for axis, angle in zip(np.eye(3), description["orientation_xyz"], strict=True):
        X[:3, :3] = X[:3, :3] @ rotation(axis, angle)
    X[:3, 3] = description["translation"]
    return X


def terms_value(terms, q):
    return sum(function_value(term["function"], q[term["coordinate"]]) for term in terms)


def placements(model, q):
    """Body → 4×4 placement in ground, for coordinates {name: value}; coupled ones are set first."""
    q = dict(q)
    for coupling in model["couplings"]:
        q[coupling["dependent"]] = function_value(coupling["function"], q[coupling["independent"]])
    placed, joints = {"ground": np.eye(4)}, list(model["joints"])
    while joints:
        joint = next(j for j in joints if j["parent"]["body"] in placed)
        joints.remove(joint)
        X = np.eye(4)
        for axis in joint["translations"]:
            amount = axis["constant"] + terms_value(axis["terms"], q)
            X[:3, 3] += amount * np.array(axis["axis"]) / np.linalg.norm(axis["axis"])
        for axis in joint["rotations"]:
            amount = axis["constant"] + terms_value(axis["terms"], q)
            X[:3, :3] = X[:3, :3] @ rotation(axis["axis"], amount)
        parent, child = joint["parent"], joint["child"]
        placed[child["body"]] = (
            placed[parent["body"]] @ frame(parent) @ X @ np.linalg.inv(frame(child))
        )
    return placed


def point_in_ground(placed, body, location):
    return placed[body][:3, :3] @ np.array(location) + placed[body][:3, 3]


def path_points(path, placed, q):
    """Points of a path in ground that are present, before any wrapping."""
    points = []
    for point in path["points"]:
        condition = point.get("condition")
        if condition and not condition["min"] <= q[condition["coordinate"]] <= condition["max"]:
            continue
        location = np.array(point["location"], dtype=float)
        for i, axis in enumerate("xyz"):
            location[i] += terms_value(point.get("moving", {}).get(axis, []), q)
        points.append(point_in_ground(placed, point["body"], location))
    return np.array(points)
