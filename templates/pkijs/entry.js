export { Certificate, CertificateChainValidationEngine, ContentInfo, SignedData } from "pkijs";
