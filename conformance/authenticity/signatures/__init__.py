"""Signatures of certificates: signing, and checking against trust roots.

The package pyHanko (extra `sign`) does the cryptography. Files of this folder import it when they are used.
"""
