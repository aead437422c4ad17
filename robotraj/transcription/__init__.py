"""Transcription: a problem on meshes becomes an inspectable nonlinear program."""

from robotraj.transcription.nlp import Nlp
from robotraj.transcription.transcribe import transcribe

__all__ = ["Nlp", "transcribe"]
