"""The front door of labsid, spelled out for editors and type checkers; `labsid/__init__.py` imports lazily."""

from labsid.estimation.armax import fit_armax as fit_armax
from labsid.estimation.instrumental import fit_instrumental as fit_instrumental
from labsid.estimation.likelihood import fit_likelihood as fit_likelihood
from labsid.estimation.recursive import recursive_armax as recursive_armax
from labsid.estimation.recursive import recursive_instrumental as recursive_instrumental
from labsid.estimation.recursive import recursive_least_squares as recursive_least_squares
from labsid.estimation.subspace import fit_subspace as fit_subspace
from labsid.gap.diagnosis import diagnose as diagnose
from labsid.lab.arx import ArxFit as ArxFit
from labsid.lab.arx import ArxModel as ArxModel
from labsid.lab.arx import arx_from_theta as arx_from_theta
from labsid.lab.arx import fit_arx as fit_arx
from labsid.lab.arx import to_ss as to_ss
from labsid.lab.arx import to_tf as to_tf
from labsid.lab.arx_system import ArxSystem as ArxSystem
from labsid.lab.arx_system import fit_arx_system as fit_arx_system
from labsid.lab.arx_system import simulate_system as simulate_system
from labsid.lab.excitation import excitation_order as excitation_order
from labsid.lab.excitation import prbs as prbs
from labsid.lab.identification import Identification as Identification
from labsid.lab.identification import identify as identify
from labsid.lab.long_arx import fit_long_arx as fit_long_arx
from labsid.lab.offset import Offsets as Offsets
from labsid.lab.offset import find_offsets as find_offsets
from labsid.lab.offset import remove_offsets as remove_offsets
from labsid.lab.record_check import check_record as check_record
from labsid.lab.record_verification import verify_on_record as verify_on_record
from labsid.lab.regressor import build_phi as build_phi
from labsid.lab.simulation import estimate_initial_state as estimate_initial_state
from labsid.lab.simulation import predict_one_step as predict_one_step
from labsid.lab.simulation import simulate as simulate
from labsid.lab.sinusoid import cut_off as cut_off
from labsid.lab.sinusoid import make_sinusoids as make_sinusoids
from labsid.lab.step_response import fit_step_response as fit_step_response
from labsid.lab.system_identification import SystemIdentification as SystemIdentification
from labsid.lab.system_identification import identify_system as identify_system
from labsid.lab.verification import Verification as Verification
from labsid.lab.verification import mse as mse
from labsid.lab.verification import verify as verify
from labsid.model_structures.order import loss_against_order as loss_against_order
from labsid.model_structures.prediction import free_run as free_run
from labsid.model_structures.prediction import one_step_prediction as one_step_prediction
from labsid.model_structures.residuals import input_residual_test as input_residual_test
from labsid.model_structures.residuals import whiteness_test as whiteness_test
from labsid.model_structures.structures import PolynomialModel as PolynomialModel
from labsid.model_structures.structures import Regression as Regression
from labsid.model_structures.structures import Structure as Structure
from labsid.model_structures.structures import fit_structure as fit_structure
from labsid.nonlinear.exponential import fit_exponential as fit_exponential
from labsid.nonlinear.solve import gauss_newton as gauss_newton
from labsid.nonlinear.solve import levenberg_marquardt as levenberg_marquardt
from labsid.records.record import Record as Record
from labsid.records.record import load_record as load_record

__version__: str
__all__: list[str]
