"""Boards: conversion of drives to the bytes of each kind of board, and the links that carry these bytes."""
